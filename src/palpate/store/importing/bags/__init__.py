"""Recordings from ROS 2 bags and MCAP files: a map says what becomes of each topic.

`read_topic_map` reads such a map, `is_bag` knows a bag, `read_bag` reads one; `Bags` is the
format for an import of many.
"""

from palpate.store.importing.bags.bags import read_bag
from palpate.store.importing.bags.format import Bags
from palpate.store.importing.bags.opening import is_bag
from palpate.store.importing.bags.reading_topics import read_topic_map
from palpate.store.importing.bags.topics import TopicMap

__all__ = ["Bags", "TopicMap", "is_bag", "read_bag", "read_topic_map"]
