#pragma once

#include "net/base/reference_policy.h"
#include "vrml/scene/source_text.h"

#include <memory>

namespace gs::app {

/// Converts the origin of a text for storage in vrml::SourceText.
[[nodiscard]] std::shared_ptr<const vrml::TextSource> source_of(const net::Origin& origin);

/// Converts back. A null source gives the least trusted origin, that of a data: URL from the Internet.
[[nodiscard]] net::Origin origin_of(const std::shared_ptr<const vrml::TextSource>& source);

}  // namespace gs::app
