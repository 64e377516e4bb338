#pragma once

// Types of requests and events, for users of the loader.
#include "net/transfer/load_types.h"
