# libpenumbra.so: everything that a program needs, in one file that shows the functions of penumbra/*.h and nothing else.
file(GLOB library_sources CONFIGURE_DEPENDS apps/library/*.cpp)
add_library(penumbra_library SHARED ${library_sources} apps/network/loaded_network.cpp apps/slam/segmenter.cpp)
set_target_properties(penumbra_library PROPERTIES OUTPUT_NAME penumbra EXPORT_NAME penumbra VERSION ${PROJECT_VERSION}
                      SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} UNITY_BUILD OFF)
target_compile_definitions(penumbra_library PRIVATE PENUMBRA_VERSION="${PROJECT_VERSION}")
target_link_libraries(penumbra_library PRIVATE $<BUILD_INTERFACE:penumbra_slam> $<BUILD_INTERFACE:penumbra_weights_tools>
                                               $<BUILD_INTERFACE:nlohmann_json::nlohmann_json>)
# Of the archives below no symbol is shown either.
target_link_options(penumbra_library PRIVATE -Wl,--exclude-libs,ALL -Wl,--no-undefined)
target_include_directories(penumbra_library PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/apps/library>)

# Penumbra::slam and Penumbra::nn are the two halves that a program may ask for; both are in the one file.
foreach(half slam nn)
  add_library(penumbra_${half}_half INTERFACE)
  set_target_properties(penumbra_${half}_half PROPERTIES EXPORT_NAME ${half})
  target_link_libraries(penumbra_${half}_half INTERFACE penumbra_library)
  target_compile_features(penumbra_${half}_half INTERFACE cxx_std_20)
endforeach()

if(PENUMBRA_PYTHON)
  find_package(Python 3.9 REQUIRED COMPONENTS Interpreter Development.Module)
  find_package(pybind11 2.10 REQUIRED)
  pybind11_add_module(penumbra_python NO_EXTRAS apps/python/penumbra_module.cpp)
  set_target_properties(penumbra_python PROPERTIES OUTPUT_NAME _penumbra UNITY_BUILD OFF BUILD_RPATH "$ORIGIN;${CMAKE_CURRENT_BINARY_DIR}"
                        INSTALL_RPATH "$ORIGIN" LIBRARY_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/python/penumbra)
  target_link_libraries(penumbra_python PRIVATE penumbra_library penumbra_options)
  # The package as it is imported from the build folder.
  file(GLOB python_files CONFIGURE_DEPENDS apps/python/penumbra/*)
  add_custom_command(TARGET penumbra_python POST_BUILD
                     COMMAND ${CMAKE_COMMAND} -E copy ${python_files} ${CMAKE_CURRENT_BINARY_DIR}/python/penumbra)
endif()
