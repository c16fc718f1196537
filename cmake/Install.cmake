# cmake --install: component "program" is what a user runs, "development" the libraries for other CMake projects.
include(CMakePackageConfigHelpers)

set(FLOWCAGE_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/flowcage)
set(libraries flowcage_core)
set(header_folders core)
if(FLOWCAGE_OCC)
  list(APPEND libraries flowcage_occ_bridge)
  list(APPEND header_folders occ_bridge)
endif()
install(TARGETS ${libraries} EXPORT flowcageTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/flowcage)
install(DIRECTORY ${header_folders} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/flowcage COMPONENT development
        FILES_MATCHING PATTERN "*.hpp" PATTERN internal EXCLUDE)
install(EXPORT flowcageTargets NAMESPACE flowcage:: DESTINATION ${FLOWCAGE_PACKAGE_DIR} COMPONENT development)
configure_package_config_file(cmake/flowcageConfig.cmake.in ${CMAKE_BINARY_DIR}/package/flowcageConfig.cmake
                              INSTALL_DESTINATION ${FLOWCAGE_PACKAGE_DIR})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/flowcageConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/package/flowcageConfig.cmake ${CMAKE_BINARY_DIR}/package/flowcageConfigVersion.cmake
              cmake/FindCGNS.cmake DESTINATION ${FLOWCAGE_PACKAGE_DIR} COMPONENT development)

if(TARGET flowcage)
  install(TARGETS flowcage COMPONENT program)
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT program)
  install(FILES CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
  # The program writes its own manual page and completions.
  set(pages ${CMAKE_BINARY_DIR}/package)
  add_custom_command(OUTPUT ${pages}/flowcage.1 ${pages}/flowcage ${pages}/_flowcage ${pages}/flowcage.fish
    COMMAND flowcage man > ${pages}/flowcage.1
    COMMAND flowcage completion bash > ${pages}/flowcage
    COMMAND flowcage completion zsh > ${pages}/_flowcage
    COMMAND flowcage completion fish > ${pages}/flowcage.fish
    DEPENDS flowcage VERBATIM)
  add_custom_target(flowcage_pages ALL DEPENDS ${pages}/flowcage.1)
  install(FILES ${pages}/flowcage.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
  install(FILES ${pages}/flowcage DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
  install(FILES ${pages}/_flowcage DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)
  install(FILES ${pages}/flowcage.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
          COMPONENT program)
endif()

# cpack: a .deb of the program; dpkg-shlibdeps finds what it needs.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME flowcage)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_CONTACT "flowcage developers <flowcage@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME flowcage)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
include(CPack)
