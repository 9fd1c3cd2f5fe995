#include "eskel_api.h"
int main(void)
{
	return 0;
}
