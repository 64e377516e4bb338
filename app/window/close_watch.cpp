#include "app/window/close_watch.h"

#if __has_include(<X11/Xlib.h>)
#define GHOSTSPACE_X11 1
#include <X11/Xlib.h>
#include <X11/keysym.h>
#endif

#include <dlfcn.h>

namespace gs::app {

#if GHOSTSPACE_X11

namespace {

// Returns a function of this program; null if it does not exist.
template <class Function>
Function* loaded(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_DEFAULT, name));
}

template <class Function>
Function* loaded_from(void* library, const char* name) {
  return library ? reinterpret_cast<Function*>(::dlsym(library, name)) : nullptr;
}

/// Input and result of the search in the event queue.
struct Search {
  Atom protocols, delete_window;
  unsigned quit_key, escape_key;
  bool found = false;
};

// Records whether an event is a request to close or to stop. Always returns False, so that XCheckIfEvent leaves all
// events to the main thread.
Bool note_request(Display*, XEvent* event, XPointer argument) {
  auto& search = *reinterpret_cast<Search*>(argument);
  if (event->type == ClientMessage && event->xclient.message_type == search.protocols &&
      static_cast<Atom>(event->xclient.data.l[0]) == search.delete_window)
    search.found = true;
  if (event->type == KeyPress && event->xkey.keycode == search.quit_key && (event->xkey.state & ControlMask) != 0)
    search.found = true;
  if (event->type == KeyPress && event->xkey.keycode == search.escape_key) search.found = true;
  return False;
}

}  // namespace

CloseWatch::CloseWatch() {
  auto* const display = loaded<Display*()>("glfwGetX11Display");
  // GLFW has already loaded libX11 if it uses X11; this only adds a reference. Null on Wayland, for example.
  void* const library = ::dlopen("libX11.so.6", RTLD_NOW | RTLD_NOLOAD);
  auto* const atom = loaded_from<decltype(XInternAtom)>(library, "XInternAtom");
  auto* const key = loaded_from<decltype(XKeysymToKeycode)>(library, "XKeysymToKeycode");
  auto* const check = loaded_from<decltype(XCheckIfEvent)>(library, "XCheckIfEvent");
  Display* const connection = display && atom && key && check ? display() : nullptr;
  if (!connection) return;
  protocols_ = atom(connection, "WM_PROTOCOLS", False);
  delete_window_ = atom(connection, "WM_DELETE_WINDOW", False);
  quit_key_ = key(connection, XK_q);
  escape_key_ = key(connection, XK_Escape);
  check_ = reinterpret_cast<void*>(check);
  display_ = connection;
}

bool CloseWatch::is_asked_to_stop() const {
  if (!display_) return false;
  Search search{protocols_, delete_window_, quit_key_, escape_key_};
  XEvent event;
  (void)reinterpret_cast<decltype(XCheckIfEvent)*>(check_)(static_cast<Display*>(display_), &event, note_request,
                                                           reinterpret_cast<XPointer>(&search));
  return search.found;
}

#else

CloseWatch::CloseWatch() = default;
bool CloseWatch::is_asked_to_stop() const { return display_ && check_; }

#endif

}  // namespace gs::app
