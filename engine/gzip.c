#include "eskel.h"
