"""One file a type; its `TYPE` is a row of `contin.special.table`."""
