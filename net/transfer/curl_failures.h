#pragma once

#include <string>

#include <curl/curl.h>

#include "net/transfer/transport.h"

namespace gs::net {

[[nodiscard]] std::string milliseconds(Milliseconds time);

/// Translates a failure of curl into a transfer result. `detail` is curl's message.
[[nodiscard]] TransferEnd describe_failure(CURLcode code, const std::string& detail, const LoaderOptions& options);

}  // namespace gs::net
