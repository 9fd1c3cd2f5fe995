#include "eskel_api.h"
