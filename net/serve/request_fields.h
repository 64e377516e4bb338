#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gs::net {

/// One header field of a request.
struct ReceivedField {
  std::string_view name, value;
  bool folded = false;  // the field continued on a second line, which began with a blank
};

/// Checks the fields of a request. `version` is, for example, "HTTP/1.1". Returns the reason if their meaning or the
/// length of the body is ambiguous (RFC 9112 2.2, 5.1, 5.2, 6.1, 6.3). Returns nullopt otherwise.
///
/// A proxy may parse an ambiguous request differently and hide another request in it. So the caller must answer 400 and
/// close the connection.
[[nodiscard]] std::optional<std::string> refuse_fields(std::span<const ReceivedField> fields, std::string_view version);

}  // namespace gs::net
