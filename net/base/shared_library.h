#pragma once

#include <string>

/// Macros for lists of functions. The first macro declares a member for a function. The second macro finds the function
/// in `library`.
#define GHOSTSPACE_LIBRARY_MEMBER(name) decltype(&::name) name = nullptr;
#define GHOSTSPACE_LIBRARY_FIND(name) library.find(#name, name);

namespace gs::net {

/// System library that is opened at first use and stays open. Linking it at program start could take longer than
/// drawing a small world. Any thread, one at a time.
class SharedLibrary {
 public:
  explicit SharedLibrary(const char* name);

  /// Finds a function by its name. `Function` must be its type in the library's header.
  template <class Function>
  void find(const char* name, Function*& function) {
    function = reinterpret_cast<Function*>(symbol(name));
  }
  /// Returns the error, or an empty string. After an error, no function of the library may be called.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  [[nodiscard]] void* symbol(const char* name);

  std::string name_;
  void* handle_ = nullptr;
  std::string problem_;
};

}  // namespace gs::net
