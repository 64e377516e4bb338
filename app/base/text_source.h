#pragma once

#include "net/base/reference_policy.h"
#include "vrml/scene/source_text.h"

#include <memory>

namespace gs::app {

/// Converts an origin to the form that vrml::SourceText stores.
[[nodiscard]] std::shared_ptr<const vrml::TextSource> source_of(const net::Origin& origin);

/// Converts the form of source_of() back to an origin. Null gives the least trusted origin: that of a data: URL from
/// the Internet.
[[nodiscard]] net::Origin origin_of(const std::shared_ptr<const vrml::TextSource>& source);

}  // namespace gs::app
