#include "eskel_store.h"
