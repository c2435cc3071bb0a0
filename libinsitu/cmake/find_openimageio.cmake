# Debian 12's OpenImageIOConfig.cmake names the folder of OpenCV's headers, which only exists where OpenCV is installed
# too, and CMake refuses targets with missing folders. We need no header of OpenCV.
find_package(OpenImageIO 2.4 REQUIRED)
get_target_property(oiio_includes OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
foreach(folder IN LISTS oiio_includes)
  if(IS_ABSOLUTE "${folder}" AND NOT EXISTS "${folder}")
    list(REMOVE_ITEM oiio_includes "${folder}")
  endif()
endforeach()
set_target_properties(OpenImageIO::OpenImageIO PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${oiio_includes}")
