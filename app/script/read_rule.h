#pragma once

#include "net/base/reference_policy.h"

#include <cstdint>
#include <string>

namespace gs::app::script {

/// Whether a Script may read the fields of a node (docs/security.md, "What Scripts may read").
enum class Reading : std::uint8_t {
  allowed,
  confidential,  // allowed, but later network requests to URLs that Scripts of this world compute need permission
  refused,
};

/// Decides by the origins of three texts: `script` is the origin of the program, `document` that of the file whose
/// scene holds the Script (another one for a Script in the body of an EXTERNPROTO), `node` that of the node.
[[nodiscard]] Reading reading(const net::Origin& script, const net::Origin& document, const net::Origin& node);

/// Name of the group of Scripts that share library objects such as Browser: one per site, and one per local file.
[[nodiscard]] std::string library_key(const net::Origin& script);

}  // namespace gs::app::script
