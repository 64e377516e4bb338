#include "net/http/curl_library.h"

namespace gs::net {

CurlLibrary::CurlLibrary() {
  SharedLibrary library("libcurl.so.4");
  GHOSTSPACE_CURL_FUNCTIONS(GHOSTSPACE_LIBRARY_FIND)
  problem = library.problem();
}

const CurlLibrary& curl() {
  static const CurlLibrary library;
  return library;
}

}  // namespace gs::net
