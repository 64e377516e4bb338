#pragma once

#include <string>

#include <curl/curl.h>

#include "net/load/transport.h"

namespace gs::net {

[[nodiscard]] std::string milliseconds(Milliseconds time);

/// Describes a failure of curl in our terms. `detail` is curl's own text.
[[nodiscard]] TransferEnd describe_failure(CURLcode code, const std::string& detail, const LoaderOptions& options);

}  // namespace gs::net
