"""How a grasp is chosen: candidates from the shape, a cheap closing that scores them, a search, files of grasps."""
