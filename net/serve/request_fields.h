#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gs::net {

/// One header field of a request.
struct ReceivedField {
  std::string_view name, value;
  bool folded = false;  // its line was continued by a line that begins with a blank
};

/// Checks the fields of a request of this version ("HTTP/1.1"). Returns the reason why their meaning or the length of
/// the body is ambiguous (RFC 9112 2.2, 5.1, 5.2, 6.1, 6.3), or nullopt. A proxy may parse such a request differently
/// and hide another request in it, so the caller must answer 400 and close the connection.
[[nodiscard]] std::optional<std::string> refuse_fields(std::span<const ReceivedField> fields, std::string_view version);

}  // namespace gs::net
