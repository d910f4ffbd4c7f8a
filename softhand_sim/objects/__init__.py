"""Objects to grasp: the catalogue's generated shapes and any mesh file, as one kind of model."""
