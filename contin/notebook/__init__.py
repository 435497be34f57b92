"""What results look like in a notebook: picture, table, folded details."""
