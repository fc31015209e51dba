"""What tests share: cases, results made by hand, programs of their own."""
