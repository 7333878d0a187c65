<!--TITLE--><!--STYLES--><!--SCRIPTS-->
