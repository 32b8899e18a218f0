layout(location = 0) out float one;

void main()
{
    one = 1.0;
}
