#include "net/serve/microhttpd_library.h"

namespace gs::net {

MicrohttpdLibrary::MicrohttpdLibrary() {
  SharedLibrary library("libmicrohttpd.so.12");
  GHOSTSPACE_MICROHTTPD_FUNCTIONS(GHOSTSPACE_LIBRARY_FIND)
  problem = library.problem();
}

const MicrohttpdLibrary& microhttpd() {
  static const MicrohttpdLibrary library;
  return library;
}

}  // namespace gs::net
