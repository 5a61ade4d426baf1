"""The shared numerics: lines, bands, the spline model of straight targets, its covariance."""
