"""Dense layers of a policy's network, for all worlds at once."""

import warp as wp

# What bends the output of a layer.
NONE = wp.constant(0)
RELU = wp.constant(1)
ELU = wp.constant(2)
LEAKY = wp.constant(3)
TANH = wp.constant(4)
SIGMOID = wp.constant(5)
SOFTPLUS = wp.constant(6)


@wp.func
def bent(x: float, bend: int, alpha: float) -> float:
    """The function of a layer's output, by its number; alpha is that of ELU and of the leaky ReLU."""
    found = x
    if wp.isnan(x):  # a maximum would hide it
        return x
    if bend == RELU:
        found = wp.max(x, 0.0)
    elif bend == ELU and x < 0.0:
        found = alpha * (wp.exp(x) - 1.0)
    elif bend == LEAKY and x < 0.0:
        found = alpha * x
    elif bend == TANH:
        found = wp.tanh(x)
    elif bend == SIGMOID:
        found = 0.5 * (wp.tanh(0.5 * x) + 1.0)
    elif bend == SOFTPLUS:
        found = wp.max(x, 0.0) + wp.log(1.0 + wp.exp(-wp.abs(x)))
    return found


@wp.kernel(enable_backward=False)
def dense(
    # Data in:
    x: wp.array2d(dtype=float),
    weight: wp.array2d(dtype=float),  # (inputs, outputs): threads that run side by side read what lies side by side
    bias: wp.array(dtype=float),
    bend: int,
    alpha: float,
    # Data out:
    y: wp.array2d(dtype=float),
):
    """A layer's outputs, each of each world by a thread of its own."""
    world, row = wp.tid()
    total = bias[row]
    for k in range(x.shape[1]):
        total += x[world, k] * weight[k, row]
    y[world, row] = bent(total, bend, alpha)
