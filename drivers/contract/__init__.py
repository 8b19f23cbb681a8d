"""What every device must be and say; all that the layers above see of the drivers."""
