#include "vdb/tree_instances.h"

STRATUM_TREE_INSTANCES(, FloatTree);
