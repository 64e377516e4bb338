#include "app/session/links.h"
#include "app/session/session.h"
#include "app/view/navigation.h"

#include <algorithm>
#include <utility>

// Requests of Script programs to the session (VRML97 4.12.10).
namespace gs::app {

void Session::take_script_news(Document& document) {
  bool told = false;
  for (ScriptMessage& message : document.runtime->take_script_messages()) {
    told = true;
    if (message.printed) message.diagnostic.file = "print";
    document.world.diagnostics.add(std::move(message.diagnostic));
  }
  if (told) log_.note(document.world.path, document.world.diagnostics);
  for (const ScriptRequest& request : document.runtime->take_script_requests()) serve(document, request);
}

// Marks the worlds that a Script opens as private, if it has read a private file. Their names may reveal its content.
void Session::keep_private(const Document& document, const Link& link) {
  if (!document.runtime || document.runtime->private_file().empty()) return;
  for (const Link::Place& place : link.places) {
    if (place.target.empty()) continue;
    private_files_[place.target] = document.runtime->private_file();
    if (const auto known = panes_.documents().document(place.target); known && known->runtime)
      known->runtime->assume_private(document.runtime->private_file());
  }
}

// Serves a request in the viewport that shows the world; the active one if several do.
std::optional<std::string> Session::serve(const Document& document, const ScriptRequest& request) {
  const auto shows = [&](std::size_t pane) {
    const View* const seen = panes_.at(pane).view();
    return seen && seen->document.get() == &document;
  };
  std::size_t pane = panes_.active();
  if (!shows(pane))
    for (const std::size_t other : panes_.visible())
      if (shows(other)) pane = other;
  if (!shows(pane)) return std::nullopt;
  View& seen = *panes_.at(pane).view();
  switch (request.kind) {
    case ScriptRequest::Kind::description:
      tell(request.text, false);
      return std::nullopt;
    case ScriptRequest::Kind::viewpoint:
      if (const auto index = find_viewpoint(seen.list->viewpoints, request.text)) jump_to_viewpoint(seen, *index);
      return std::nullopt;
    case ScriptRequest::Kind::load_url: {
      Link link = link_of(request.urls, request.parameters, *request.origin, request.source);
      // Without a recent press, the user did not ask for a web page.
      constexpr double kAfterPress = 3;
      if (now_ - pressed_at_ > kAfterPress)
        for (Link::Place& place : link.places)
          if (place.for_browser) place.problem = place.target + ": not opened without a recent click";
      keep_private(document, link);
      if (request.from_client || document.controlled) keep_to_readable_files(link, *request.origin, load_.allowed);
      follow_link(pane, link);
      const auto may_open = [](const Link::Place& place) { return place.problem.empty(); };
      if (link.places.empty() || std::any_of(link.places.begin(), link.places.end(), may_open)) return std::nullopt;
      return link.places.front().problem;
    }
    case ScriptRequest::Kind::program:
    case ScriptRequest::Kind::create_from_url:
      return std::nullopt;  // handled by the world itself
  }
  return std::nullopt;
}

}  // namespace gs::app
