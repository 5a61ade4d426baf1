"""Numerical methods that the fits of two or more kinds of target share.

- normal_equations, marginal_likelihood: linear models with priors whose amplitudes the data set.
- noise: its level, its outliers, its correlation; robust scales.
- gaussian_pixel, gaussian_pixel_2d: a Gaussian seen through a pixel, with its derivatives.
- process_modes, lorentz_tail: the corrections that a prior allows; shape_error: what they leave.
- otf_modes, otf_families (learned by learn_otf), combined_prior: those of a transfer function in
  two dimensions, and directions in them that sensors of a family take; otf_kernels (learned by
  learn_kernels): taps of kernels, whole pixels apart.
- clipping: pixels at the end of the scale; repeated_pixels, jpeg_blocks, periodic_noise: what
  resampling and compression left of them (pixel_steps: the step of their numbers).
- stacked: complex values as real ones.
- lookup: cubic interpolation of tables; bessel_table: Bessel functions of many orders;
  one_thread: linear algebra of many small matrices.
"""
