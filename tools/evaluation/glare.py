"""Glare: images of lamps on the tops of robots, in rendered games of the arena whose commands are unknown."""
import json
import math
import pathlib
import random

import judging
import scenes

# A robot is struck for half a second, and each third of them at a time. The first frames have no glare.
BLOCK, FREE = 30, 30
LIGHTS = (0.15, 0.5)


def spots_of(truth, side_of, light, seed):
    """Returns the things of each picture, and the numbers of the robots that glare strikes there, by file.

    A spot keeps its place relative to the robot for a block of frames. Its diameter is one to three robot sides.
    """
    things, struck = {}, {}
    for frame, one in enumerate(truth[FREE:]):
        block = frame // BLOCK
        spots = things.setdefault(one["file"], [])
        struck[one["file"]] = [i for i in range(len(one["robots"])) if (i + block) % 3 == 0]
        for i in struck[one["file"]]:
            draw = random.Random(f"{seed} {block} {i}")
            side = side_of(one["robots"][i])
            center = judging.mean([one["robots"][i]["team_px"], *one["robots"][i]["ident_px"]])
            size = side * draw.uniform(1, 3)
            spots.append({"kind": "glare", "u": center[0] + side * draw.uniform(-0.3, 0.3),
                          "v": center[1] + side * draw.uniform(-0.3, 0.3), "size": size, "light": light})
    return things, struck
