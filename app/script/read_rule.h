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

/// Decides from three origins. `script`: the program. `document`: the file that owns the scene with the Script. `node`:
/// the node. The first two differ for a Script in the body of an EXTERNPROTO.
[[nodiscard]] Reading reading(const net::Origin& script, const net::Origin& document, const net::Origin& node);

/// Name of the group of Scripts that share library objects such as Browser: one per site, and one per local file.
[[nodiscard]] std::string library_key(const net::Origin& script);

}  // namespace gs::app::script
