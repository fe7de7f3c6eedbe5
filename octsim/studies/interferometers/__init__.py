"""The thesis's section 2 by the pipeline: a Michelson interferometer, and two or more plates."""
