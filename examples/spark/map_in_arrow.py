"""Every outcome of many states on Spark, with the Python package on each worker.

    python map_in_arrow.py ROBOT.urdf STATES.parquet RESULTS.parquet

States have the columns of a table of states: `id`, `q_base_x`, ..., `v_...`, `friction`. Each result row has the id.
"""

import functools
import sys

import numpy as np
import pyarrow as pa


@functools.cache
def robot(urdf):
    import heelstrike

    return heelstrike.Robot(urdf)


def table(urdf, states):
    """The results of a table of states; a cell without a number refuses its row alone."""
    names = ["base_x", "base_z", "base_pitch", *robot(urdf).coordinates[3:]]

    def column(name):
        return states[name].cast(pa.float64()).fill_null(np.nan).to_numpy(zero_copy_only=False)

    q, v = (np.stack([column(f"{part}_{name}") for name in names], axis=1) for part in "qv")
    # Spark uses all cores already.
    answers = robot(urdf).impacts(q, v, friction=column("friction"), place="lowest", threads=1)
    return answers.to_arrow(id=states["id"])


def answered(urdf, batches):
    for batch in batches:
        yield from table(urdf, batch).combine_chunks().to_batches()


def answer(spark, urdf, states):
    """The data frame of results."""
    from pyspark.sql.pandas.types import from_arrow_schema, to_arrow_schema

    schema = from_arrow_schema(table(urdf, to_arrow_schema(states.schema).empty_table()).schema)
    return states.mapInArrow(functools.partial(answered, urdf), schema)


if __name__ == "__main__":
    from pyspark.sql import SparkSession

    urdf, states, results = sys.argv[1:]
    session = SparkSession.builder.appName("heelstrike").getOrCreate()
    answer(session, urdf, session.read.parquet(states)).write.parquet(results)
