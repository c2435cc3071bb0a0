# Installs the build into an empty prefix, moves it, and builds and runs host/ against it with find_package and with
# pkg-config:
#   cmake -DBUILD=<build folder> -DHOST=<host folder> -DWORK=<scratch folder> -DC_COMPILER=cc -DC_FLAGS=... -P this
cmake_minimum_required(VERSION 3.25)
function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY "${WORK}" RESULT_VARIABLE result OUTPUT_VARIABLE output
    ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "failed (${result}): ${command}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()
function(expect_version output)
  if(NOT output MATCHES "insitu [0-9]+\\.[0-9]+\\.[0-9]+")
    message(FATAL_ERROR "the host did not print a version:\n${output}")
  endif()
  string(STRIP "${output}" output)
  message(STATUS "${output}")
endfunction()

file(REMOVE_RECURSE "${WORK}")
file(MAKE_DIRECTORY "${WORK}")
run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${WORK}/first")
# A moved tree must still work: nothing of the prefix may be written into the files.
file(RENAME "${WORK}/first" "${WORK}/prefix")

file(GLOB_RECURSE headers RELATIVE "${WORK}/prefix" "${WORK}/prefix/include/*")
if(NOT headers STREQUAL "include/insitu/insitu.h")
  message(FATAL_ERROR "installed headers: ${headers}; only include/insitu/insitu.h is meant to be")
endif()

message(STATUS "find_package")
run("${CMAKE_COMMAND}" -S "${HOST}" -B "${WORK}/cmake" "-DCMAKE_PREFIX_PATH=${WORK}/prefix"
    "-DCMAKE_C_COMPILER=${C_COMPILER}" "-DCMAKE_C_FLAGS=${C_FLAGS}")
run("${CMAKE_COMMAND}" --build "${WORK}/cmake")
run("${WORK}/cmake/host")
expect_version("${output}")

message(STATUS "pkg-config")
file(GLOB_RECURSE pc_file "${WORK}/prefix/*/insitu.pc")
cmake_path(GET pc_file PARENT_PATH pc_folder)
set(ENV{PKG_CONFIG_PATH} "${pc_folder}")
run(pkg-config --cflags --libs insitu)
separate_arguments(flags UNIX_COMMAND "${output}")
separate_arguments(c_flags UNIX_COMMAND "${C_FLAGS}")
run(pkg-config --variable=libdir insitu)
string(STRIP "${output}" libdir)
run("${C_COMPILER}" -std=c99 ${c_flags} "${HOST}/host.c" ${flags} "-Wl,-rpath,${libdir}" -o "${WORK}/host")
run("${WORK}/host")
expect_version("${output}")

# A library that has lost its encoder says so, and lives on.
message(STATUS "without the encoder")
file(GLOB_RECURSE encoder "${WORK}/prefix/*/libinsitu_image.so*")
file(REMOVE ${encoder})
execute_process(COMMAND "${WORK}/host" WORKING_DIRECTORY "${WORK}" RESULT_VARIABLE result ERROR_VARIABLE output)
if(NOT result EQUAL 2 OR NOT output MATCHES "host.png.*the image encoder cannot be loaded.*libinsitu_image")
  message(FATAL_ERROR "a missing encoder ended the host with ${result}:\n${output}")
endif()
