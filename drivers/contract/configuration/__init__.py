"""Configuration files: read strictly, validated, and refused in lines that people understand."""
