# What the component sdk needs, and its target armature::sdk.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4)
find_dependency(TBB)
find_dependency(tl-expected)
include("${CMAKE_CURRENT_LIST_DIR}/armature-sdk-targets.cmake")
