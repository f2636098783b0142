# The licences of the libraries whose code is in the program or in the report's page, as Debian's packages bring
# them: one text that the program carries (`penumbra --licences`).

# penumbra_collect_licences(FILE): writes FILE.
function(penumbra_collect_licences file)
  set(text "")
  set(of_processor "")
  if(NOT processor STREQUAL "x86_64")
    set(of_processor "SIMDe|the kernels of bytes|libsimde-dev")
  endif()
  # name | where its code is | the packages that may bring its licence
  foreach(entry IN ITEMS
      "three.js|in the report's page|libjs-three"
      "libpng|reads and writes PNG|libpng-dev"
      "libjpeg-turbo|reads and writes JPEG|libjpeg62-turbo-dev,libjpeg-turbo8-dev,libjpeg-dev"
      "zlib|compression of PNG and zip files|zlib1g-dev"
      "libdeflate|unpacks plain PNGs|libdeflate-dev"
      "lz4|unpacks recordings of robots|liblz4-dev"
      "bzip2|unpacks recordings of robots|libbz2-dev"
      "Zstandard|unpacks recordings of robots|libzstd-dev"
      "SQLite|reads recordings of ROS 2|libsqlite3-dev"
      "Eigen|linear algebra|libeigen3-dev"
      "xsimd|vector registers|libxsimd-dev"
      ${of_processor}
      "fmt|formatting of text|libfmt-dev"
      "spdlog|messages on stderr|libspdlog-dev"
      "CLI11|the command line|libcli11-dev"
      "JSON for Modern C++|JSON|nlohmann-json3-dev"
      "GCC's runtime: libstdc++, libgcc|C++|libstdc++6,gcc-12-base"
      "GNU C library|C, within the static program|libc6")
    string(REPLACE "|" ";" fields "${entry}")
    list(GET fields 0 name)
    list(GET fields 1 role)
    list(GET fields 2 packages)
    string(REPLACE "," ";" packages "${packages}")
    set(licence "")
    foreach(package IN LISTS packages)
      if(EXISTS ${CMAKE_SYSROOT}/usr/share/doc/${package}/copyright)
        file(READ ${CMAKE_SYSROOT}/usr/share/doc/${package}/copyright licence)
        break()
      endif()
    endforeach()
    if(NOT licence)
      message(WARNING "no licence text of ${name} found: penumbra --licences will only name it")
      set(licence "(its text was not found where this program was built)\n")
    endif()
    string(REPEAT "=" 100 rule)
    string(APPEND text "${rule}\n${name}: ${role}\n${rule}\n\n${licence}\n")
  endforeach()
  file(GENERATE OUTPUT ${file} CONTENT "${text}")
endfunction()
