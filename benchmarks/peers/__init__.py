"""What the library is compared with, written as a competent user would write it."""
