# Shows mini-apps/hello_spheres.c in README.md, as it is.
#   cmake -P libinsitu/cmake/show_source.cmake               writes the block between the markers
#   cmake -DCHECK=ON -P libinsitu/cmake/show_source.cmake    fails when README and file differ
cmake_minimum_required(VERSION 3.25)
include("${CMAKE_CURRENT_LIST_DIR}/readme_block.cmake")
get_filename_component(root "${CMAKE_CURRENT_LIST_DIR}/../.." ABSOLUTE)
file(READ "${root}/mini-apps/hello_spheres.c" source)
readme_block("${root}/README.md" hello_spheres.c "```c\n${source}```\n" "${CHECK}"
             "cmake -P libinsitu/cmake/show_source.cmake")
