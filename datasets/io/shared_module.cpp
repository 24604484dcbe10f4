// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/shared_module.h"

#include <system_error>

#include <dlfcn.h>

#include "core/base/error.h"

namespace stillpoint::datasets {

namespace fs = std::filesystem;

std::vector<std::string> module_paths(const fs::path& program, const std::string& name) {
  const std::string file = "libstillpoint_" + name + ".so";
  const fs::path folder = program.parent_path();
  return {(folder / "lib" / file).string(),
          (folder.parent_path() / STILLPOINT_LIBRARY_FOLDER / file).string(),
          (folder.parent_path() / "lib" / file).string(), file};
}

const void* module_symbol(const std::string& name, const std::string& symbol) {
  std::error_code unknown;  // leaves the path empty
  std::string problem;
  for (const std::string& path : module_paths(fs::read_symlink("/proc/self/exe", unknown), name)) {
    const bool is_bare = path.find('/') == std::string::npos;
    if (!is_bare && !fs::exists(path)) continue;
    void* const module = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL | RTLD_NODELETE);
    const void* const address = module != nullptr ? dlsym(module, symbol.c_str()) : nullptr;
    if (address != nullptr) return address;
    problem = dlerror();
    if (!is_bare) break;
  }
  throw InputError("libstillpoint_" + name + ".so",
                   "cannot be loaded (" + problem + "); install it with the libraries that it requires");
}

}  // namespace stillpoint::datasets
