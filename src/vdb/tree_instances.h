// The grids of this project are instantiated once, here, and not in every unit that makes one: a unit that only creates
// and fills three kinds of grids takes 49 s to compile without this and 10 s with it (GCC 12 -O3; 61 s and 7 s with
// clang and AddressSanitizer).
//
// Part of the precompiled headers (cmake/precompiled.cmake); sources include openvdb/openvdb.h and compile without it.
// RootNode and LeafNode are left out: some of their members don't compile (OpenVDB 10.0: RootNode::stealChild,
// LeafNode::str), which shows only where all members are instantiated.
#pragma once

#include <openvdb/openvdb.h>

// EXTERN is `extern`, or empty in the one unit that holds the instances.
// NOLINTBEGIN(bugprone-macro-parentheses): keywords and types, which can't be in parentheses
#define STRATUM_TREE_INSTANCES(EXTERN, TREE)                                                                           \
    EXTERN template class openvdb::Grid<openvdb::TREE>;                                                                \
    EXTERN template class openvdb::tree::Tree<openvdb::TREE::RootNodeType>;                                            \
    EXTERN template class openvdb::tree::InternalNode<openvdb::tree::InternalNode<openvdb::TREE::LeafNodeType, 4>, 5>; \
    EXTERN template class openvdb::tree::InternalNode<openvdb::TREE::LeafNodeType, 4>
// NOLINTEND(bugprone-macro-parentheses)

STRATUM_TREE_INSTANCES(extern, FloatTree);  // level sets, attributes
STRATUM_TREE_INSTANCES(extern, Int32Tree);  // layers, tools, features, objects
STRATUM_TREE_INSTANCES(extern, Vec3STree);  // colors
