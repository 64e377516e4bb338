#pragma once

#include "net/base/reference_policy.h"

#include <cstdint>
#include <string>

namespace gs::app::script {

/// Permission of a Script to read the fields of a node (docs/security.md, "What Scripts may read").
enum class Reading : std::uint8_t {
  allowed,
  confidential,  // allowed; then Scripts of this world need permission to request URLs that they compute
  refused,
};

/// Decides whether a Script may read a node, from three origins: `script` of the program, `document` of the file that
/// owns the Script's scene, and `node` of the node. `script` and `document` differ for a Script in the body of an
/// EXTERNPROTO.
[[nodiscard]] Reading reading(const net::Origin& script, const net::Origin& document, const net::Origin& node);

/// Returns the name of the group of Scripts that share library objects such as Browser. There is one group for each
/// site and for each local file.
[[nodiscard]] std::string library_key(const net::Origin& script);

}  // namespace gs::app::script
