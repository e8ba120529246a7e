"""Go on from a trained network: its weights in one that is as wide, or wider.

What is new begins with random weights before it and none after it, so that the wider network tells what the other did (as
Chen et al. 2016, Net2Net, but without twins that learn the same).
"""

from pathlib import Path

import onnx
import torch
from onnx import numpy_helper
from torch import Tensor, nn

from lab.training.network import INPUT_PX, Network


def begin_with(network: Network, path: Path) -> None:
    """Set the network's weights from those of a file that `train_joint_network` wrote.

    Raises ValueError where that one has other layers, or wider ones.
    """
    graph = onnx.load(str(path)).graph
    kept = {
        one.name: torch.from_numpy(numpy_helper.to_array(one).copy()) for one in graph.initializer
    }
    nodes = [node for node in graph.node if node.op_type == "Conv"]
    layers = _in_order(network)
    if len(nodes) != len(layers):
        raise ValueError(f"{path}: {len(nodes)} convolutions; the network has {len(layers)}")
    trained = {
        layer: (kept[node.input[1]], kept[node.input[2]])
        for node, layer in zip(nodes, layers, strict=True)
    }
    up = trained[network.head][0].shape[1]
    for layer, (weight, bias) in trained.items():
        columns = torch.arange(weight.shape[1])
        if layer is network.toes[0][0]:  # what it takes is two layers' beside each other
            columns[columns >= up] += network.head.weight.shape[1] - up
        _fill(layer, weight, bias, columns)


def _in_order(network: Network) -> list[nn.Conv2d]:
    """Its convolutions in the order in which a picture meets them, but for the one that training alone has."""
    met: list[nn.Conv2d] = []
    hooks = [
        one.register_forward_hook(lambda layer, *_: met.append(layer))
        for one in network.modules()
        if isinstance(one, nn.Conv2d) and one is not network.yaw
    ]
    network(torch.zeros(1, 4, INPUT_PX, INPUT_PX))
    for hook in hooks:
        hook.remove()
    return met


@torch.no_grad()
def _fill(layer: nn.Conv2d, weight: Tensor, bias: Tensor, columns: Tensor) -> None:
    o = len(weight)
    if (
        weight.shape[2:] != layer.weight.shape[2:]
        or o > len(layer.weight)
        or columns.max() >= layer.weight.shape[1]
    ):
        raise ValueError(f"weights {tuple(weight.shape)} do not fit in {tuple(layer.weight.shape)}")
    nn.init.kaiming_normal_(layer.weight, nonlinearity="relu")
    assert layer.bias is not None
    layer.bias.zero_()
    layer.bias[:o] = bias
    layer.weight[:o] = 0.0
    layer.weight[:o, columns] = weight
