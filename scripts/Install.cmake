# Rules for `cmake --install` (the folders of the freedesktop specifications), and for the Debian package by CPack.
# scripts/package.sh builds the package.
include(GNUInstallDirs)
find_package(Python3 REQUIRED COMPONENTS Interpreter)

set(desktop_name org.ghostspace.GhostSpace)
set(made ${CMAKE_BINARY_DIR}/desktop)
# Generates FILE with `ghostspace ARGUMENTS`, from the program's own tables.
function(ghostspace_makes file)
  add_custom_command(OUTPUT ${made}/${file} COMMAND ${CMAKE_COMMAND} -E make_directory ${made}
                     COMMAND ghostspace ${ARGN} > ${made}/${file}.new
                     COMMAND ${CMAKE_COMMAND} -E rename ${made}/${file}.new ${made}/${file}
                     DEPENDS ghostspace VERBATIM)
  set_property(GLOBAL APPEND PROPERTY ghostspace_made ${made}/${file})
endfunction()
ghostspace_makes(ghostspace.1 man)
ghostspace_makes(${desktop_name}.desktop desktop entry)
ghostspace_makes(${desktop_name}.xml desktop mime)
ghostspace_makes(${desktop_name}.metainfo.xml desktop metainfo)
ghostspace_makes(ghostspace.thumbnailer desktop thumbnailer)
ghostspace_makes(ghostspace.bash desktop bash)
ghostspace_makes(ghostspace.zsh desktop zsh)
ghostspace_makes(ghostspace.fish desktop fish)
add_custom_command(OUTPUT ${made}/icons/hicolor/scalable/apps/${desktop_name}.svg
                   COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/scripts/draw_icons.py ${made}/icons
                   DEPENDS ${PROJECT_SOURCE_DIR}/scripts/draw_icons.py VERBATIM)
find_program(GZIP_PROGRAM gzip REQUIRED)
add_custom_command(OUTPUT ${made}/ghostspace.1.gz COMMAND ${GZIP_PROGRAM} -9nkf ${made}/ghostspace.1
                   DEPENDS ${made}/ghostspace.1 VERBATIM)
set_property(GLOBAL APPEND PROPERTY ghostspace_made ${made}/ghostspace.1.gz)
# A Debian package contains a changelog.
string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)
set(contact "GhostSpace <ghostspace@localhost>")
file(WRITE ${made}/changelog "ghostspace (${PROJECT_VERSION}) stable; urgency=low\n\n  * Version ${PROJECT_VERSION}.\n\n\
 -- ${contact}  ${now}\n")
add_custom_command(OUTPUT ${made}/changelog.gz COMMAND ${GZIP_PROGRAM} -9nkf ${made}/changelog
                   DEPENDS ${made}/changelog VERBATIM)
set_property(GLOBAL APPEND PROPERTY ghostspace_made ${made}/changelog.gz)
get_property(all GLOBAL PROPERTY ghostspace_made)
add_custom_target(desktop_files ALL DEPENDS ${all} ${made}/icons/hicolor/scalable/apps/${desktop_name}.svg)

install(TARGETS ghostspace RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
# ghostspace-mpi is not in the package: `cmake --install DIR --component cluster` installs it.
if(TARGET ghostspace-mpi)
  install(TARGETS ghostspace-mpi RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT cluster EXCLUDE_FROM_ALL)
endif()
# The program looks for it beside its own folder.
install(TARGETS ghostspace_datasets LIBRARY DESTINATION lib/ghostspace)
# The library for simulations, with its headers, and files for pkg-config, CMake and Python.
install(TARGETS insitu_library LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} NAMELINK_COMPONENT development)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/app/insitu/include/ghostspace DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
file(RELATIVE_PATH ghostspace_insitu_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)  # of any prefix
configure_file(${PROJECT_SOURCE_DIR}/app/insitu/ghostspace-insitu.pc.in ${made}/ghostspace-insitu.pc @ONLY)
install(FILES ${made}/ghostspace-insitu.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
include(CMakePackageConfigHelpers)
configure_package_config_file(${PROJECT_SOURCE_DIR}/app/insitu/ghostspace-insitu-config.cmake.in
                              ${made}/ghostspace-insitu-config.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/ghostspace-insitu
                              PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_LIBDIR)
write_basic_package_version_file(${made}/ghostspace-insitu-config-version.cmake VERSION 1.0.0
                                 COMPATIBILITY SameMajorVersion)
install(FILES ${made}/ghostspace-insitu-config.cmake ${made}/ghostspace-insitu-config-version.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/ghostspace-insitu)
# Debian's Python looks in dist-packages of /usr and /usr/local. Elsewhere, set PYTHONPATH (docs/insitu.md).
install(DIRECTORY ${PROJECT_SOURCE_DIR}/app/insitu/python/ghostspace_insitu DESTINATION lib/python3/dist-packages
        FILES_MATCHING PATTERN "*.py")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/app/insitu/examples ${PROJECT_SOURCE_DIR}/app/insitu/python/examples
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/ghostspace/insitu
        FILES_MATCHING PATTERN "*.c" PATTERN "*.h" PATTERN "*.py")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/assets/worlds ${PROJECT_SOURCE_DIR}/assets/protos
        DESTINATION ${CMAKE_INSTALL_DATADIR}/ghostspace)
install(FILES ${made}/ghostspace.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${made}/${desktop_name}.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications)
install(FILES ${made}/${desktop_name}.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages)
install(FILES ${made}/${desktop_name}.metainfo.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/metainfo)
install(FILES ${made}/ghostspace.thumbnailer DESTINATION ${CMAKE_INSTALL_DATADIR}/thumbnailers)
install(DIRECTORY ${made}/icons/hicolor DESTINATION ${CMAKE_INSTALL_DATADIR}/icons)
install(FILES ${made}/ghostspace.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME ghostspace)
install(FILES ${made}/ghostspace.zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions RENAME _ghostspace)
install(FILES ${made}/ghostspace.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
install(FILES ${made}/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/ghostspace)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/images/manual DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/ghostspace/images)
foreach(document manual faq formats serving security control scripts insitu)
  install(FILES ${PROJECT_SOURCE_DIR}/docs/${document}.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/ghostspace)
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME ghostspace)
set(CPACK_PACKAGE_VENDOR GhostSpace)
set(CPACK_PACKAGE_CONTACT "${contact}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "browser for 3D worlds and remote scientific data")
set(CPACK_PACKAGE_DESCRIPTION "GhostSpace opens VRML97 worlds, meshes, volumes and Gaussian
splats, in a window or from the command line, shows them while they
come over the network, and says what is wrong with a file.")
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/package)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Libraries that are opened at run time. All users need rendering without a display, fonts and the network. The
# recommended packages are for sounds, movies and 3D mice.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libosmesa6, fonts-dejavu-core, libcurl4, libmicrohttpd12")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libgl1, libopenal1, libavcodec59, libavformat59, libswscale6, libfluidsynth3, \
timgm6mb-soundfont, shared-mime-info, desktop-file-utils, xdg-utils, ca-certificates")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "spacenavd, libspnav0, zenity | kdialog")
include(CPack)
