"""Many small linear systems at once, singular ones by steps of least norm."""

import numpy as np

from ...models.types import Array, Mask

FEW = 100
"""Up to so many systems LAPACK is faster."""


def solve_many(matrix: Array, right: Array) -> tuple[Array, Array]:
    """Solve N systems of size k by Gaussian elimination with partial pivoting.

    The samples run along the last axis, so that each operation of the elimination is one
    vector operation: for k of two or three and thousands of samples this is twice as fast as
    LAPACK on a stack of matrices, which does the few.

    Parameters
    ----------
    matrix
        Shape (k, k, N), overwritten.
    right
        Shape (k, N), overwritten.

    Returns
    -------
    tuple[Array, Array]
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


WEAK = 1e-7
"""A determinant below this fraction of the product of the rows' sizes asks for a closer look:
dividing by it would lose more digits than the least-norm solution does."""
RANK = 1e-10
"""Singular values below this fraction of the largest count as zero: they belong to the direction
along which a straight pulley's place is undetermined (Y 6.1.1), and stem from rounding."""
CONSISTENT = 1e-6
"""Largest residual of a singular system that has a solution, over the size of its terms; beyond it
the path asks for what no tension can give, and there is none."""


def least_norm(
    matrix: Array, right: Array, values: Array, determinant: Array
) -> tuple[Array, Mask]:
    """Solutions (k, N) with those of (nearly) singular systems replaced by the shortest ones.

    Parameters
    ----------
    matrix, right
        As for `solve_many`, not overwritten.
    values, determinant
        What that returned.

    Returns
    -------
    tuple[Array, Mask]
        The solutions, and which of the systems (N,) have none.
    """
    sizes = np.abs(matrix).max(axis=1)
    weak = ~(np.abs(determinant) > WEAK * np.prod(sizes, axis=0))
    weak &= np.isfinite(matrix).all(axis=(0, 1)) & np.isfinite(right).all(axis=0)
    unsolved = np.zeros(len(weak), dtype=bool)
    if not weak.any():
        return values, unsolved
    scale = np.where(sizes > 0, sizes, 1.0)[:, weak]
    stack = (matrix[..., weak] / scale[:, None]).transpose(2, 0, 1)
    goal = right[:, weak] / scale
    shortest = np.einsum("nij,jn->in", np.linalg.pinv(stack, rcond=RANK), goal)
    wrong = np.abs(np.einsum("nij,jn->in", stack, shortest) - goal).max(axis=0)
    size = np.abs(shortest).max(axis=0) + np.abs(goal).max(axis=0)
    unsolved[weak] = ~(wrong <= CONSISTENT * size)
    result = values.copy()
    result[:, weak] = shortest
    return result, unsolved
