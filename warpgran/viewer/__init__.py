"""One HTML page to look at results in a browser, offline: `page.view`."""
