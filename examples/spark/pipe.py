"""Every outcome of many states on Spark, with the command on each worker and no Python package.

    python pipe.py ROBOT.urdf STATES.ndjson RESULTS

`line` of a result counts within its partition; results are joined by their ids.
"""

import shlex
import sys

from pyspark.sql import SparkSession


def answer(lines, urdf, command="heelstrike"):
    """Lines of results for lines of states. A line that is refused is a result; a crash ends the job."""
    batch = [command, "batch", urdf, "-", "--quiet", "--refused", "ok", "--threads", "1"]
    return lines.pipe(shlex.join(batch), checkCode=True)


if __name__ == "__main__":
    urdf, states, results = sys.argv[1:]
    session = SparkSession.builder.appName("heelstrike").getOrCreate()
    answer(session.sparkContext.textFile(states), urdf).saveAsTextFile(results)
