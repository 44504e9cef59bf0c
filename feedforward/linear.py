"""Many small linear systems at once."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FEW = 100
"""Up to so many systems LAPACK is faster."""


def solve_many(matrix: Array, right: Array) -> tuple[Array, Array]:
    """Solve N systems of size k by Gaussian elimination with partial pivoting.

    The samples run along the last axis, so that each operation of the elimination is one
    vector operation: for k of two or three and thousands of samples this is twice as fast as
    LAPACK on a stack of matrices, which does the few.

    Args:
        matrix: shape (k, k, N), overwritten.
        right: shape (k, N), overwritten.

    Returns:
        The solutions (k, N), not finite where a system is singular, and the determinants (N,).
    """
    size, samples = right.shape
    if samples <= FEW:
        stack = matrix.transpose(2, 0, 1)
        determinant: Array = np.linalg.det(stack)
        if determinant.all():
            return np.asarray(np.linalg.solve(stack, right.T[..., None])[..., 0].T), determinant
    determinant = np.ones(samples)
    every = np.arange(samples)
    for i in range(size):
        if i + 1 < size:
            pivot = i + np.abs(matrix[i:, i]).argmax(axis=0)
            swapped = pivot != i
            if swapped.any():
                rows, cols = pivot[swapped], every[swapped]
                for array in (matrix, right):
                    upper = array[i, ..., swapped].copy()
                    array[i, ..., swapped] = array[rows, ..., cols]
                    array[rows, ..., cols] = upper
                determinant[swapped] *= -1.0
        determinant *= matrix[i, i]
        for j in range(i + 1, size):
            factor = matrix[j, i] / matrix[i, i]
            matrix[j, i + 1 :] -= factor * matrix[i, i + 1 :]
            right[j] -= factor * right[i]
    for i in reversed(range(size)):
        for j in range(i + 1, size):
            right[i] -= matrix[i, j] * right[j]
        right[i] /= matrix[i, i]
    return right, determinant
