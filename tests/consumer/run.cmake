# Install into an empty prefix, then configure, build and run hosts in several languages against that prefix alone.
file(REMOVE_RECURSE ${SCRATCH})
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
# Staged as a packager does it, below a directory that is not the prefix; nothing may land outside.
set(ENV{DESTDIR} ${SCRATCH}/stage)
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix /usr)
unset(ENV{DESTDIR})
file(GLOB staged RELATIVE ${SCRATCH}/stage ${SCRATCH}/stage/*)
if(NOT staged STREQUAL "usr" OR NOT EXISTS ${SCRATCH}/stage/usr/include/comminute.h)
  message(FATAL_ERROR "an install below DESTDIR left '${staged}'")
endif()

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${SCRATCH}/prefix)
if(SHARED)
  # A shared library carries what it links: its host has none of it.
  set(nothing -DCMAKE_DISABLE_FIND_PACKAGE_FFTW3=ON -DCMAKE_DISABLE_FIND_PACKAGE_hwy=ON -DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON)
endif()
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${SCRATCH}/build -G ${GENERATOR}
    -DCMAKE_PREFIX_PATH=${SCRATCH}/prefix -DWANTED_VERSION=${VERSION} -DTREE=${TREE} -DCMAKE_CXX_COMPILER=${CXX_COMPILER}
    -DCMAKE_CXX_FLAGS=${CXX_FLAGS} -DCMAKE_C_FLAGS=${CXX_FLAGS} -DWITH_FORTRAN=${WITH_FORTRAN} -DNATIVE=${NATIVE} ${nothing})
run(${CMAKE_COMMAND} --build ${SCRATCH}/build)
foreach(host consumer consumer20 consumer_native umat)
  if(EXISTS ${SCRATCH}/build/${host})
    run(${SCRATCH}/build/${host})
  endif()
endforeach()
set(hosts ${SCRATCH}/build/reference ${SCRATCH}/build/host_c)
if(WITH_FORTRAN)
  list(APPEND hosts ${SCRATCH}/build/host_fortran)
endif()
if(LIBRARY)
  list(APPEND hosts "${PYTHON} ${TREE}/tests/hosts/ctypes_host.py ${LIBRARY}")
endif()
run(${PYTHON} ${TREE}/tests/hosts/same_numbers.py ${hosts})

# The example hosts, each with its picture where Python can draw.
run(${CMAKE_COMMAND} -S ${TREE}/examples/oedometer -B ${SCRATCH}/oedometer -G ${GENERATOR}
    -DCMAKE_PREFIX_PATH=${SCRATCH}/prefix -DCMAKE_CXX_COMPILER=${CXX_COMPILER} -DCMAKE_CXX_FLAGS=${CXX_FLAGS} ${nothing})
run(${CMAKE_COMMAND} --build ${SCRATCH}/oedometer)
set(example ${TREE}/examples/oedometer)
run(${SCRATCH}/oedometer/oedometer ${example}/sand.csv ${example}/path.csv ${SCRATCH}/oedometer)
execute_process(COMMAND ${PYTHON} -c "import matplotlib" RESULT_VARIABLE no_matplotlib ERROR_QUIET)
if(NOT no_matplotlib)
  run(${PYTHON} ${example}/draw.py ${SCRATCH}/oedometer)
  file(SIZE ${SCRATCH}/oedometer/oedometer.png size)
  if(size LESS 20000)
    message(FATAL_ERROR "the picture of the oedometer has ${size} bytes")
  endif()
endif()

# The same by pkg-config, where there is one.
find_program(PKG_CONFIG pkg-config)
if(PKG_CONFIG AND NOT CXX_FLAGS MATCHES "sanitize")
  file(GLOB_RECURSE pc ${SCRATCH}/prefix/*/comminute.pc)
  get_filename_component(directory "${pc}" DIRECTORY)
  set(ENV{PKG_CONFIG_PATH} ${directory})
  if(SHARED)
    set(static "")
  else()
    set(static --static)
  endif()
  execute_process(COMMAND ${PKG_CONFIG} ${static} --cflags --libs comminute OUTPUT_VARIABLE flags
                  OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  run(${CXX_COMPILER} -std=c++17 ${CMAKE_CURRENT_LIST_DIR}/main.cpp -o ${SCRATCH}/by_pkg_config ${flags})
  file(GLOB libraries ${SCRATCH}/prefix/lib*)
  set(ENV{LD_LIBRARY_PATH} ${libraries})
  run(${SCRATCH}/by_pkg_config)
endif()

# As a part of another project the library installs nothing, and changes none of its host's settings.
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/part -B ${SCRATCH}/part -G ${GENERATOR} -DTREE=${TREE}
    -DCMAKE_CXX_COMPILER=${CXX_COMPILER} -DCMAKE_BUILD_TYPE=)
run(${CMAKE_COMMAND} --install ${SCRATCH}/part --prefix ${SCRATCH}/nothing)
if(EXISTS ${SCRATCH}/nothing)
  message(FATAL_ERROR "as a part of another project the library installed something")
endif()
