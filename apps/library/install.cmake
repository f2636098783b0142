# Where things go: the program, the library with its headers and what finds it, tiny weights, completion, manual page.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS penumbra RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES weights_tools/models/penumbra-tiny.safetensors DESTINATION ${CMAKE_INSTALL_DATADIR}/penumbra)

configure_file(apps/library/penumbra.1.in penumbra.1 @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/penumbra.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES apps/library/penumbra.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME penumbra)

if(TARGET penumbra_library)
  install(TARGETS penumbra_library penumbra_slam_half penumbra_nn_half EXPORT PenumbraTargets
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
          INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(DIRECTORY apps/library/penumbra DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  set(cmake_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Penumbra)
  install(EXPORT PenumbraTargets NAMESPACE Penumbra:: FILE PenumbraConfig.cmake DESTINATION ${cmake_folder})
  # Before version 1 the second number says whether programs must be compiled anew.
  write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/PenumbraConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/PenumbraConfigVersion.cmake DESTINATION ${cmake_folder})
  configure_file(apps/library/penumbra.pc.in penumbra.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/penumbra.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()

# The wheel's part: the module beside the library that it needs.
if(TARGET penumbra_python)
  install(TARGETS penumbra_python penumbra_library LIBRARY DESTINATION penumbra COMPONENT python EXCLUDE_FROM_ALL
          NAMELINK_SKIP)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME penumbra)
set(CPACK_PACKAGE_CONTACT "Penumbra's maintainers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Visual SLAM that sees half-hidden things, on the CPU")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
include(CPack)
