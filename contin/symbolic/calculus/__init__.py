"""What passes calculate with: derivatives, series, removable singularities, values at samples."""
