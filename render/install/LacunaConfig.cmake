# Targets: Lacuna::lacuna, the library; Lacuna::methods, the same with the inner headers.
include(CMakeFindDependencyMacro)
find_dependency(TBB 2021 CONFIG)
include(${CMAKE_CURRENT_LIST_DIR}/LacunaTargets.cmake)
