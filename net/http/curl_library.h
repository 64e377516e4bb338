#pragma once

#include "net/base/shared_library.h"

#include <curl/curl.h>

#include <string>

/// Functions of libcurl that the program calls.
#define GHOSTSPACE_CURL_FUNCTIONS(X) \
  X(curl_easy_cleanup)               \
  X(curl_easy_getinfo)               \
  X(curl_easy_init)                  \
  X(curl_easy_pause)                 \
  X(curl_easy_setopt)                \
  X(curl_free)                       \
  X(curl_getdate)                    \
  X(curl_global_init)                \
  X(curl_multi_add_handle)           \
  X(curl_multi_cleanup)              \
  X(curl_multi_info_read)            \
  X(curl_multi_init)                 \
  X(curl_multi_perform)              \
  X(curl_multi_poll)                 \
  X(curl_multi_remove_handle)        \
  X(curl_multi_setopt)               \
  X(curl_multi_wakeup)               \
  X(curl_slist_append)               \
  X(curl_slist_free_all)             \
  X(curl_url)                        \
  X(curl_url_cleanup)                \
  X(curl_url_get)                    \
  X(curl_url_set)

namespace gs::net {

/// Functions of libcurl, loaded at first use. Loading libcurl with its dependencies (TLS, Kerberos, LDAP, ...) takes a
/// third of the program's start-up time, and local files do not need it.
struct CurlLibrary {
  CurlLibrary();

  std::string problem;  // empty on success; otherwise no function may be called
  GHOSTSPACE_CURL_FUNCTIONS(GHOSTSPACE_LIBRARY_MEMBER)
};
/// Returns the library. Any thread.
[[nodiscard]] const CurlLibrary& curl();

// Deleters of curl's handles for std::unique_ptr.
struct FreeEasy {
  void operator()(CURL* easy) const { curl().curl_easy_cleanup(easy); }
};
struct FreeMulti {
  void operator()(CURLM* multi) const { curl().curl_multi_cleanup(multi); }
};
struct FreeList {
  void operator()(curl_slist* list) const { curl().curl_slist_free_all(list); }
};

}  // namespace gs::net
