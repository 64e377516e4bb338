#pragma once

#include <string>
#include <string_view>

namespace gs::net {

/// Returns a presigned URL without the parameters of its signature. A signature gives temporary access without an
/// account, at Amazon S3 and compatible stores, Google Cloud Storage, CloudFront and Azure. Keeps other parameters,
/// such as the version of an object. Returns other URLs and paths unchanged.
///
/// Use the result for messages, logs and cache keys, and never for requests.
[[nodiscard]] std::string without_signature(std::string_view url);
/// Reports whether a URL carries such a signature.
[[nodiscard]] bool is_presigned(std::string_view url);

}  // namespace gs::net
