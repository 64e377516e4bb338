#pragma once

#include <string>

#include <curl/curl.h>

#include "net/load/transport.h"

namespace gs::net {

[[nodiscard]] std::string milliseconds(Milliseconds time);

/// curl's failures in our words. `detail` is curl's own text.
[[nodiscard]] TransferEnd describe_failure(CURLcode code, const std::string& detail, const LoaderOptions& options);

}  // namespace gs::net
